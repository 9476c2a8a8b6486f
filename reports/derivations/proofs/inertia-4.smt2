; $R L^2 \le \frac{3\sqrt3}{16\sqrt\rho}$, squared and with $q = R^2$, $L = R/(\rho + R^2)$
(set-logic QF_NRA)
(declare-const q Real)
(declare-const rho Real)
(assert (> q 0))
(assert (> rho 0))
(assert (> (* 256 rho (* q q q)) (* 27 (* (+ q rho) (+ q rho) (+ q rho) (+ q rho)))))
(check-sat)
