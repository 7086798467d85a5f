# SPDX-License-Identifier: Apache-2.0
# What the fuzzer does where clang is missing: it fails and says how to get it.
message(FATAL_ERROR "clang is missing, so nothing is fuzzed. ./tools/dev setup proofs fetches it; "
                    "then configure again.")
