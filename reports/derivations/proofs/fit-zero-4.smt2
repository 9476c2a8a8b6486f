; one more trial: $F + f = 0$ with both not negative means that both are 0
(set-logic QF_NRA)
(declare-const F Real)
(declare-const f Real)
(assert (>= F 0))
(assert (>= f 0))
(assert (= (+ F f) 0))
(assert (not (and (= F 0) (= f 0))))
(check-sat)
