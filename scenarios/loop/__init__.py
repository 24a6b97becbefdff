"""The closed loop, tick by tick, with its events, faults and the oracle."""
