; and at most all of it
(set-logic QF_NRA)
(declare-const u_x Real)
(declare-const u_y Real)
(assert (= (+ (* u_x u_x) (* u_y u_y)) 1))
(assert (not (and (<= (* (- 1) u_x) 1) (<= u_x 1) (<= (* (- 1) u_y) 1) (<= u_y 1))))
(check-sat)
