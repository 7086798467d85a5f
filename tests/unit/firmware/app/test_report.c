/* SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "app/report.h"
#include "boot_fixture.h"
#include "core/findings.h"
#include "motor/feasible_torque.h"
#include "unity.h"
#include "wheel_address.h"

static boot_report_t boot;
static slow_output_t output;
static node_t node;
static report_status_t status;
static text_t line;
static char page[4096];
static size_t page_length;

void setUp(void)
{
    boot = successful_boot();
    output = output_in_ready();
    const node_limits_t limits = {.pack = {.charge_current_mA = 1000, .discharge_current_mA = 1000},
                                  .largest_drive_mNm = 100000,
                                  .largest_brake_mNm = 100000,
                                  .demand_lost_frames = 2};
    node_init(&node, address_of(MESSAGES_FRONT_LEFT), &limits, 0);
    const report_status_t running = {.output = &output,
                                     .node = &node,
                                     .fast_cycles_worst = 321,
                                     .stack_free_bytes = 2048,
                                     .control = true};
    status = running;
    text_clear(&line);
    page_length = 0;
    page[0] = '\0';
}

void tearDown(void) {}

/* All lines of an answer, each with its end. */
static void keep(void)
{
    text_add(&line, "\n");
    TEST_ASSERT_TRUE(page_length + line.length < sizeof page);
    memcpy(&page[page_length], line.chars, line.length + 1U);
    page_length += line.length;
    text_clear(&line);
}

static void turn_page(void)
{
    page_length = 0;
    page[0] = '\0';
}

static void read_boot(void)
{
    for (uint32_t i = 0; report_boot(&boot, i, &line); i++) {
        keep();
    }
}

static void assert_on_page(const char *words)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(page, words), page);
}

static void assert_in_line(const char *words)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(line.chars, words), line.chars);
}

void test_the_banner_names_program_configuration_checksum_and_wheel(void)
{
    report_banner(&boot, &line);
    assert_in_line("hubfoc ");
    /* "hubfoc 1.2.3 (0123456789ab+) on host, ..." */
    const char *commit = strstr(line.chars, " (");
    TEST_ASSERT_NOT_NULL_MESSAGE(commit, line.chars);
    const size_t digits = strspn(commit + 2, "0123456789abcdef+unkow");
    TEST_ASSERT_GREATER_THAN_UINT(6, digits);
    TEST_ASSERT_EQUAL_STRING_LEN(") on host, ", commit + 2 + digits, 11);
    assert_in_line(CONFIG_IMAGE.name);
    text_t crc;
    text_clear(&crc);
    text_add_hex(&crc, CONFIG_IMAGE.crc32);
    assert_in_line(crc.chars);
    assert_in_line(", wheel ");
    assert_in_line(messages_wheel_text((messages_wheel_t)CONFIG_IMAGE.vehicle.wheel_position));
}

void test_banner_does_not_print_the_name_of_a_refused_configuration(void)
{
    boot.config_result.code = CONFIG_RESULT_MAGIC;
    boot.config = NULL; /* would crash if it were read */
    report_banner(&boot, &line);
    TEST_ASSERT_NULL(strstr(line.chars, "configuration"));
}

void test_successful_boot_prints_three_lines(void)
{
    read_boot();
    TEST_ASSERT_EQUAL_STRING(
        "self-test RAM: good\nself-test firmware CRC: good\nconfiguration accepted\n", page);
}

static config_result_t refusal(config_result_code_t code, const char *field)
{
    const config_result_t result = {.code = code,
                                    .section = "",
                                    .field = field,
                                    .relation = "",
                                    .upper_section = "",
                                    .upper_field = ""};
    return result;
}

void test_refused_field_is_printed_with_its_value_and_range(void)
{
    boot.config_result = config_result_range("motor.", "pole_pairs", 0, 1, 60);
    read_boot();
    assert_on_page("configuration refused: motor.pole_pairs is 0, accepted 1 .. 60\n");
}

void test_violated_relation_and_wrong_checksum_are_printed(void)
{
    boot.config_result = refusal(CONFIG_RESULT_RELATION, "a within b");
    read_boot();
    boot.config_result.relation = " <= ";
    boot.config_result.upper_section = "c.";
    boot.config_result.upper_field = "d";
    read_boot();
    boot.config_result = refusal(CONFIG_RESULT_CRC, "crc32");
    read_boot();
    assert_on_page("configuration refused: a within b does not hold\n");
    assert_on_page("configuration refused: a within b <= c.d does not hold\n");
    assert_on_page("configuration refused: crc32 is not what this firmware expects\n");
}

void test_failed_self_tests_and_clock_are_printed(void)
{
    boot.clock_good = false;
    boot.ram_good = false;
    boot.firmware_good = false;
    boot.reset_cause = RESET_WATCHDOG;
    read_boot();
    assert_on_page("clock fault");
    assert_on_page("RAM: FAILED");
    assert_on_page("CRC: FAILED");
    assert_on_page("started by watchdog");
}

void test_every_known_cause_of_the_reset_has_its_own_text(void)
{
    static const char *const WORDS[RESET_CAUSES] = {
        [RESET_POWER] = "started by supply\n",
        [RESET_BROWN_OUT] = "started by low supply\n",
        [RESET_PIN] = "started by reset pin\n",
        [RESET_OPTION_BYTES] = "started by option bytes\n",
        [RESET_PROGRAM] = "started by program\n",
        [RESET_WATCHDOG] = "started by watchdog\n",
        [RESET_WINDOW_WATCHDOG] = "started by window watchdog\n",
        [RESET_LOW_POWER] = "started by low-power mode\n",
    };
    boot.reset_cause = RESET_UNKNOWN;
    read_boot();
    TEST_ASSERT_NULL(strstr(page, "started by"));
    for (reset_cause_t cause = RESET_POWER; cause < RESET_CAUSES; cause++) {
        boot.reset_cause = cause;
        turn_page();
        read_boot();
        assert_on_page(WORDS[cause]);
    }
}

void test_every_refusal_of_a_port_has_its_own_text(void)
{
    static const inverter_status_t BAD[] = {
        INVERTER_FREQUENCY_UNSUPPORTED, INVERTER_DEAD_TIME_UNSUPPORTED,
        INVERTER_TIMER_UNREADY,         INVERTER_CONVERTER_UNREADY,
        INVERTER_DRIVER_UNREADY,        INVERTER_OVERCURRENT_UNREADY};
    static const char *const WORDS[] = {"drive.pwm_frequency_Hz",
                                        "drive.dead_time_ns",
                                        "PWM timer",
                                        "converters",
                                        "gate driver",
                                        "comparators"};
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        boot.inverter = BAD[i];
        turn_page();
        read_boot();
        assert_on_page(WORDS[i]);
        TEST_ASSERT_NULL(strstr(page, "accepted"));
    }
}

void test_status_prints_mode_reason_and_values_in_si_units(void)
{
    output.mode = MODE_RUN;
    output.torque_reason = REASON_LOSS_OPTIMUM;
    output.motor_torque_estimate_mNm = -20450;
    report_status(&status, &line);
    assert_in_line("RUN, ");
    assert_in_line(reason_text(REASON_LOSS_OPTIMUM));
    assert_in_line("-20.450 N m");
    assert_in_line("53.012 V");
    assert_in_line("321 cycles");
    assert_in_line("demand NO_DATA");
}

void test_status_names_what_the_gate_driver_reported_and_only_then(void)
{
    report_status(&status, &line);
    TEST_ASSERT_NULL(strstr(line.chars, "gate driver"));
    text_clear(&line);
    status.driver_status =
        INVERTER_DRIVER_OVER_CURRENT_LOW_A | INVERTER_DRIVER_SUPPLY_LOW | INVERTER_DRIVER_LOST;
    report_status(&status, &line);
    assert_in_line("; gate driver: over-current low a supply low settings lost");
    status.driver_status = 0;
}

void test_status_names_what_the_mode_waits_for_and_only_then(void)
{
    output.mode = MODE_READY;
    output.torque_reason = REASON_TORQUE_ENABLE;
    output.waits_for = WAITS_FOR_PEDAL_RELEASE;
    report_status(&status, &line);
    assert_in_line("READY, torque not enabled in this mode, waits for the drive pedal's release; ");
    text_clear(&line);
    output.waits_for = WAITS_FOR_NONE;
    report_status(&status, &line);
    TEST_ASSERT_NULL(strstr(line.chars, "waits"));
}

void test_latched_fault_is_printed_instead_of_the_limit(void)
{
    output.mode = MODE_FAULT;
    output.fault_reason = REASON_OVERCURRENT;
    report_status(&status, &line);
    assert_in_line(reason_text(REASON_OVERCURRENT));
    TEST_ASSERT_NULL(strstr(line.chars, reason_text(REASON_TORQUE_ENABLE)));
}

void test_status_without_control_is_only_boot(void)
{
    status.control = false;
    status.output = NULL;
    status.node = NULL;
    report_status(&status, &line);
    assert_in_line("BOOT, bridge off");
    text_clear(&line);
    TEST_ASSERT_TRUE(report_can(&status, 0, &line));
    assert_in_line("BOOT, bridge off");
    TEST_ASSERT_FALSE(report_can(&status, 1, &line));
}

/* ---- torque limits ---- */

/* The table as it is before the first step, which has no bound. */
static torque_limits_t unbounded(void)
{
    torque_limits_state_t state;
    torque_limits_t limits;
    torque_limits_init(&state, &limits);
    return limits;
}

static void read_limits(const torque_limits_t *limits)
{
    for (uint32_t i = 0; report_limits(&status, limits, i, &line); i++) {
        keep();
    }
}

void test_limits_begin_with_the_tightest_of_each_side_and_its_reason(void)
{
    torque_limits_t limits = unbounded();
    limits.driving[TORQUE_LINE_MAX_TORQUE] = limit_init(40000, REASON_MAX_TORQUE);
    limits.braking[TORQUE_LINE_MAX_TORQUE] = limit_init(40000, REASON_MAX_TORQUE);
    limits.driving[TORQUE_LINE_WINDING] = limit_init(12345, REASON_WINDING_TEMPERATURE);
    limits.braking[TORQUE_LINE_WINDING] = limit_init(12345, REASON_WINDING_TEMPERATURE);
    limits.braking[TORQUE_LINE_LOSS_OPTIMUM] = limit_init(9000, REASON_LOSS_OPTIMUM);
    read_limits(&limits);
    assert_on_page("driving 12.345 N m, WINDING: winding temperature derating\n"
                   "braking 9.000 N m, LOSS_OPTIMUM: more torque would return less energy\n"
                   "line            driving N m   braking N m   reason\n");
    assert_on_page("MAX_TORQUE      40.000        40.000        motor torque limit\n");
    assert_on_page("WINDING         12.345 *      12.345        winding temperature derating\n");
    assert_on_page(
        "LOSS_OPTIMUM    -             9.000 *       more torque would return less energy\n");
    assert_on_page("ABS             -             -\n");
}

void test_every_line_of_the_table_is_shown_once_with_both_bounds_and_its_reason(void)
{
    torque_limits_t limits = unbounded();
    for (int at = 0; at < (int)TORQUE_LINE_COUNT; at++) {
        limits.driving[at] = limit_init(2000 + at, (reason_t)(at + 1));
        limits.braking[at] = limit_init(1000 + at, (reason_t)(at + 1));
    }
    read_limits(&limits);
    const char *from = page;
    for (int at = 0; at < (int)TORQUE_LINE_COUNT; at++) {
        text_t shown;
        text_clear(&shown);
        text_add(&shown, "\n");
        text_add(&shown, torque_limits_line_text((torque_line_t)at));
        text_add_until(&shown, 17);
        text_add_decimal(&shown, 2000 + at, 3);
        text_add(&shown, at == 0 ? " *" : "");
        text_add_until(&shown, 31);
        text_add_decimal(&shown, 1000 + at, 3);
        text_add(&shown, at == 0 ? " *" : "");
        text_add_until(&shown, 45);
        text_add(&shown, reason_text((reason_t)(at + 1)));
        text_add(&shown, "\n");
        from = strstr(from, shown.chars);
        TEST_ASSERT_NOT_NULL_MESSAGE(from, shown.chars);
        from++;
    }
}

void test_the_reason_of_a_line_that_bounds_driving_alone_is_shown(void)
{
    torque_limits_t limits = unbounded();
    limits.driving[TORQUE_LINE_MAX_SPEED] = limit_init(0, REASON_MAX_SPEED);
    read_limits(&limits);
    assert_on_page("MAX_SPEED       0.000 *       -             speed limit\n");
}

void test_the_largest_bound_and_the_longest_reason_are_complete(void)
{
    torque_limits_t limits = unbounded();
    limits.braking[TORQUE_LINE_ELECTRIC_RATED] =
        limit_init(FEASIBLE_UNBOUNDED - 1, REASON_ELECTRIC_RATED);
    read_limits(&limits);
    assert_on_page("2147483.646 *");
    assert_on_page("rated electric braking torque of the parallel brake\n");
}

void test_limits_without_control_are_only_boot(void)
{
    status.control = false;
    TEST_ASSERT_TRUE(report_limits(&status, NULL, 0, &line));
    assert_in_line("BOOT, bridge off");
    TEST_ASSERT_FALSE(report_limits(&status, NULL, 1, &line));
}

void test_longest_status_is_complete(void)
{
    output.mode = MODE_OFFSET_CAL;
    output.torque_reason = REASON_ELECTRIC_RATED; /* the longest text of all */
    output.waits_for = WAITS_FOR_LOWER_SPEED;     /* here too */
    output.motor_torque_estimate_mNm = -20000000;
    output.motor_torque_command_mNm = -20000000;
    output.speed_mrad_s = -5000000;
    output.bus_voltage_mV = 2000000;
    output.bus_current_mA = -2000000;
    status.fast_cycles_worst = 8400;
    status.stack_free_bytes = 131072;
    report_status(&status, &line);
    TEST_ASSERT_EQUAL_STRING("NO_DATA", &line.chars[line.length - strlen("NO_DATA")]);
}

void test_every_kind_of_frame_error_has_its_count(void)
{
    const wheel_demand_t demand = {.enable = true};
    for (uint8_t counter = 0; counter < 3; counter++) {
        const messages_frame_t frame =
            messages_demand(&demand, address_of(MESSAGES_FRONT_LEFT), counter);
        (void)node_receive(&node, &frame, 10);
        (void)node_receive(&node, &frame, 10);
    }
    for (uint32_t i = 0; report_can(&status, i, &line); i++) {
        keep();
    }
    assert_on_page("demand VALID; used 1, lost 0, repeated 3, out of sequence 0, damaged 0, "
                   "implausible 0, timeouts 0\n");
    assert_on_page("battery NO_DATA; used 0, ");
    assert_on_page("battery peak NO_DATA; used 0, ");
    assert_on_page("hydraulic NO_DATA; used 0, ");
    assert_on_page("bus on, foreign frames 0\n");
}

void test_faults_are_printed_with_the_configured_times(void)
{
    for (uint32_t i = 0; report_faults(&boot, "BUS_", i, &line); i++) {
        keep();
    }
    assert_on_page("68 BUS_OVERVOLTAGE: bus over-voltage; motor off, brakes work; stop and "
                   "acknowledge\n   after monitor.battery_message_time_ms 300: freewheel at once");
    assert_on_page("69 BUS_UNDERVOLTAGE: bus under-voltage; ");
    assert_on_page("after monitor.battery_message_time_ms 300 + monitor.voltage_fault_time_ms 5: ");
    assert_on_page("ends latched until acknowledged at standstill without a torque demand\n");
    TEST_ASSERT_FALSE(report_faults(&boot, "BUS_", 8, &line)); /* 3 faults, 5 checks */
}

/* In the order of causes; a trip that no other check finds is that of the fast monitor. */
void test_each_check_that_finds_a_fault_is_printed_beneath_it(void)
{
    for (uint32_t i = 0; report_faults(&boot, "BUS_SENSOR", i, &line); i++) {
        keep();
    }
    assert_on_page("97 BUS_SENSOR: bus voltage reads wrong, against the battery's, the EMF or its "
                   "range; have it repaired\n"
                   "   after at once: freewheel at once, or short circuit if safer, until it ends;"
                   " ends by itself, after its heal time, 100 ms\n"
                   "   after 200 ms: less driving torque, whole braking torque;"
                   " ends by itself, after its heal time, 200 ms\n"
                   "   after 200 ms: none, it is only reported;"
                   " ends by itself, after its heal time, 200 ms\n");
    for (uint32_t i = 0; report_faults(&boot, "OVERCURRENT", i, &line); i++) {
        keep();
    }
    assert_on_page("67 OVERCURRENT: phase over-current; motor off, brakes work; stop and "
                   "acknowledge\n   after 1 PWM period and more: freewheel "
                   "at once, or short "
                   "circuit on a stuck side; ends latched until acknowledged");
}

/* From the lists themselves. */
static uint32_t lines_of_all_faults(void)
{
#define CODE(number, identifier, text, clearing, driver) REASON_##identifier,
#define FOUND(check, reason, evidence, qualify, heal, explained_by, reaction) REASON_##reason,
    static const reason_t CODES[] = {FAULT_LIST(CODE)};
    static const reason_t FOUND_BY[] = {FINDING_LIST(FOUND)};
#undef CODE
#undef FOUND
    uint32_t lines = 0;
    for (uint32_t i = 0; i < sizeof CODES / sizeof CODES[0]; i++) {
        uint32_t checks = 0;
        for (uint32_t k = 0; k < sizeof FOUND_BY / sizeof FOUND_BY[0]; k++) {
            checks += FOUND_BY[k] == CODES[i] ? 1U : 0U;
        }
        lines += 1U + (checks > 0U ? checks : 1U);
    }
    return lines;
}

void test_lines_of_faults_fit_and_a_refused_configuration_shows_no_values(void)
{
    boot.config_result.code = CONFIG_RESULT_CRC;
    uint32_t lines = 0;
    for (; report_faults(&boot, "", lines, &line); lines++) {
        TEST_ASSERT_LESS_THAN_UINT32(TEXT_CAPACITY - 1, line.length);
        text_clear(&line);
    }
    TEST_ASSERT_EQUAL_UINT32(lines_of_all_faults(), lines);
    TEST_ASSERT_TRUE(report_faults(&boot, "DEMAND_TIMEOUT", 1, &line));
    assert_in_line("after brake.demand_timeout_ms: ");
}

void test_bus_off_is_printed(void)
{
    status.bus_off = true;
    TEST_ASSERT_TRUE(report_can(&status, 4, &line));
    assert_in_line("bus off");
}

void test_configuration_is_printed_with_its_identity_first(void)
{
    TEST_ASSERT_TRUE(report_config(&boot, "motor.pole", 0, &line));
    assert_in_line(CONFIG_IMAGE.name);
    TEST_ASSERT_EQUAL_UINT32(CONFIG_FORMAT_VERSION, CONFIG_IMAGE.format_version);
    text_t format;
    text_clear(&format);
    text_add(&format, ", format ");
    text_add_integer(&format, CONFIG_FORMAT_VERSION);
    assert_in_line(format.chars);
    text_clear(&line);
    TEST_ASSERT_TRUE(report_config(&boot, "motor.pole", 1, &line));
    assert_in_line("motor.pole_pairs ");
    TEST_ASSERT_FALSE(report_config(&boot, "motor.pole", 2, &line));
}

void test_only_the_refusal_of_a_refused_configuration_is_printed(void)
{
    boot.config_result = refusal(CONFIG_RESULT_CRC, "crc32");
    boot.config = NULL;
    TEST_ASSERT_TRUE(report_config(&boot, "", 0, &line));
    assert_in_line("configuration refused: crc32");
    TEST_ASSERT_FALSE(report_config(&boot, "", 1, &line));
}
