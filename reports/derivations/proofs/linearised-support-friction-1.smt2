; $n_d = 4$: the best corner dissipates at least $1/\sqrt{2}$ of the full friction
(set-logic QF_NRA)
(declare-const u_x Real)
(declare-const u_y Real)
(assert (= (+ (* u_x u_x) (* u_y u_y)) 1))
(assert (not (or (and (>= (* 2 (* u_x u_x)) 1) (> (* (- 1) u_x) 0)) (and (>= (* 2 (* u_x u_x)) 1) (> u_x 0)) (and (>= (* 2 (* u_y u_y)) 1) (> (* (- 1) u_y) 0)) (and (>= (* 2 (* u_y u_y)) 1) (> u_y 0)))))
(check-sat)
