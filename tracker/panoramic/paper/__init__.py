"""One person, as the OMNIVIS 2003 paper tracks one."""
