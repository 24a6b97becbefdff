"""Resumable tasks, executed in local processes or on a Dask cluster."""
