# SPDX-License-Identifier: Apache-2.0
# What a proof does where the checker is missing: it fails and says how to get it.
message(FATAL_ERROR "CBMC is missing, so nothing is proved. "
  "./tools/dev setup proofs fetches it; then configure again.")
