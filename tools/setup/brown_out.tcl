# SPDX-License-Identifier: Apache-2.0
# For OpenOCD: the STM32F405's option bytes with brown-out level 3 (RM0090, 3.7 and 3.9.10): the
# chip resets itself below 2.7 V, where its flash cannot be read at full clock.
#
# Nothing but the level is changed, and only of a chip without read and write protection, so that a
# value that was not read well cannot lock the chip.

proc brown_out_read {} {
    return [expr {[lindex [read_memory 0x40023C14 32 1] 0] & 0xFFFFFFFF}]
}

proc brown_out_level_3 {} {
    set options [brown_out_read]
    if {($options & 0x0FFFFF00) != 0x0FFFAA00} {
        echo [format "brown-out level not set: protected, option bytes 0x%08X" $options]
        return
    }
    if {($options & 0xC) == 0} {
        echo "brown-out level 3 was set"
        return
    }
    mww 0x40023C08 0x08192A3B
    mww 0x40023C08 0x4C5D6E7F
    set wanted [expr {$options & ~0xF}]
    mww 0x40023C14 $wanted
    mww 0x40023C14 [expr {$wanted | 2}]
    sleep 200
    mww 0x40023C14 [expr {$wanted | 1}]
    if {([brown_out_read] & 0xC) == 0} {
        echo "brown-out level set to 3"
    } else {
        echo "brown-out level not set: the option bytes did not take it"
    }
}
