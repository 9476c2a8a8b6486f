; an error of ±5 µm makes an excess of 7 to 9 µm
(set-logic QF_NRA)
(declare-const e_end Real)
(declare-const excess Real)
(assert (and (>= excess 7) (<= excess 9)))
(assert (= excess e_end))
(assert (and (>= e_end (- 5)) (<= e_end 5)))
(check-sat)
