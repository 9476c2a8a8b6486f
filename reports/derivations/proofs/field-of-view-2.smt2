; all pixels of a 640 × 480 camera with that field of view
(set-logic QF_NRA)
(declare-const pixel_um Real)
(assert (> pixel_um 0))
(assert (and (>= (* (/ 16 25) pixel_um) (/ 673 200)) (<= (* (/ 16 25) pixel_um) (/ 27 8))))
(assert (and (>= (* (/ 12 25) pixel_um) (/ 503 200)) (<= (* (/ 12 25) pixel_um) (/ 101 40))))
(assert (not (and (> pixel_um (/ 525781 100000)) (< pixel_um (/ 263021 50000)))))
(check-sat)
