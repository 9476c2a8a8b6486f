; one error of the orientation rounds to 0.005° and to 0.3°
(set-logic QF_NRA)
(declare-const error_deg Real)
(assert (> error_deg 0))
(assert (and (>= error_deg (/ 9 2000)) (<= error_deg (/ 11 2000))))
(assert (and (>= error_deg (/ 1 4)) (<= error_deg (/ 7 20))))
(check-sat)
