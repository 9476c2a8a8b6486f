; one more sample: $S + e^2 = 0$ with $S \ge 0$ means $S = 0$ and $e = 0$
(set-logic QF_NRA)
(declare-const S Real)
(declare-const e Real)
(assert (>= S 0))
(assert (= (+ S (* e e)) 0))
(assert (not (and (= S 0) (= e 0))))
(check-sat)
