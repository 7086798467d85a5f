# SPDX-License-Identifier: Apache-2.0
"""Many runs of one scenario with keys that vary: a grid, random draws, or both.

On Dask; one Parquet table as the result.

``plan`` lists the runs, ``work`` executes some of them in one process, ``store`` keeps what
is done so that a sweep that was interrupted goes on, ``conduct`` hands the work out.
"""
