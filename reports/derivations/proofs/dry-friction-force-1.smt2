; friction of $p_1^*$ between 0.1 and 100 µN
(set-logic QF_NRA)
(declare-const force Real)
(assert (= force (/ 2071694239857 625000000000000000)))
(assert (>= force (/ 1 10000000)))
(assert (<= force (/ 1 10000)))
(check-sat)
