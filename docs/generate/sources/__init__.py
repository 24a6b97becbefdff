"""The shipped page of reproduced tables and figures, from a run of `peopleboy reproduce`."""
