; $|\sin\phi\cos\phi| \le 1/2$
(set-logic QF_NRA)
(declare-const L Real)
(declare-const cos_phi Real)
(declare-const sin_phi Real)
(assert (> L 0))
(assert (= (+ (* cos_phi cos_phi) (* sin_phi sin_phi)) 1))
(assert (not (and (>= (* (/ 1 2) cos_phi sin_phi (* L L)) (* (- (/ 1 4)) (* L L))) (<= (* (/ 1 2) cos_phi sin_phi (* L L)) (* (/ 1 4) (* L L))))))
(check-sat)
