; also at the middle corner
(set-logic QF_NRA)
(assert true)
(assert false)
(check-sat)
