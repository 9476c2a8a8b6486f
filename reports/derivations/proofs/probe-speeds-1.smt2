; each of the three is in range
(set-logic QF_NRA)
(declare-const speed_um Real)
(assert (> speed_um 0))
(assert (or (= speed_um (/ 37 5)) (= speed_um 75) (= speed_um 140)))
(assert (not (and (>= speed_um (/ 8 5)) (<= speed_um 1700))))
(check-sat)
