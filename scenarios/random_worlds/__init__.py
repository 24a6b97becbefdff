"""Random worlds as scenario data, sampled from a declared distribution."""
