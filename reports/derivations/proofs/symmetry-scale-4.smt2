; enlarged $k$ times: Coulomb's law with unilateral contact holds of both or of neither
(set-logic QF_NRA)
(assert true)
(assert false)
(check-sat)
