"""The closed loop, step by step, with its events, faults and the oracle tracker."""
