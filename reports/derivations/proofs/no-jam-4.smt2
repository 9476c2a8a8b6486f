; one of the five states holds, whatever the corner rates
(set-logic QF_NRA)
(declare-const g Real)
(declare-const r_0 Real)
(declare-const r_e Real)
(declare-const r_m Real)
(assert (> g 0))
(assert (not (or (and (>= r_m (* (- (/ 1 2)) g)) (<= r_m (* (/ 1 2) g))) (and (> r_0 (* (/ 1 2) g)) (< r_m (* (/ 1 2) g))) (and (> r_e (* (- (/ 1 2)) g)) (< r_m (* (- (/ 1 2)) g))) (and (> r_m (* (- (/ 1 2)) g)) (< r_e (* (- (/ 1 2)) g))) (and (> r_m (* (/ 1 2) g)) (< r_0 (* (/ 1 2) g))) (>= r_0 (* (/ 1 2) g)) (<= r_e (* (- (/ 1 2)) g)))))
(check-sat)
