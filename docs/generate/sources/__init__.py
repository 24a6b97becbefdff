"""The page of the sources' tables and figures that is shipped, from a run of `peopleboy reproduce`."""
