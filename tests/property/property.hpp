/* SPDX-License-Identifier: Apache-2.0 */
/*
 * property.hpp: assertions for properties, on top of Unity.
 *
 * Unity leaves a failed test by longjmp, which runs no destructor. A property therefore never
 * asserts while its objects live: CHECK records a counterexample and goes on, and tearDown()
 * (property.cpp), which Unity calls after the test function has returned, fails the test if there
 * is any. SHOW names a variable whose value belongs to every counterexample of its scope.
 *
 *     for (const double speed_rpm : {0.0, 50.0}) {
 *         SHOW(speed_rpm);
 *         CHECK(error_A(speed_rpm) <= 0.5);
 *     }
 *
 * prints "error_A(speed_rpm) <= 0.5, with 0.71 <= 0.5; speed_rpm = 50". CHECK is an expression that
 * is true if the condition holds, so that a test can stop where going on makes no sense. A
 * condition is one comparison or one truth value.
 */
#pragma once

#include <cmath>
#include <string>
#include <type_traits>

#include <unity.h>

namespace property {

// A value as text. Types of the tests add an overload in their own namespace.
std::string number(double value);
template <typename T> std::string text(const T &value)
{
    if constexpr (std::is_same_v<T, bool>) {
        return value ? "true" : "false";
    } else if constexpr (std::is_arithmetic_v<T>) {
        return number(static_cast<double>(value));
    } else if constexpr (std::is_convertible_v<T, std::string>) {
        return value;
    } else {
        std::string out; // a column vector
        for (int n = 0; n < static_cast<int>(value.size()); n++) {
            out += (n == 0 ? "(" : ", ") + number(value[n]);
        }
        return out + ")";
    }
}

// A condition taken apart, so that a counterexample shows both sides.
template <typename L, typename R> struct Comparison {
    bool holds;
    const L &left;
    const char *sign;
    const R &right;

    std::string sides() const { return text(left) + sign + text(right); }
};

template <typename L> struct Left {
    const L &value;
    bool holds = false;

    template <typename R> Comparison<L, R> operator==(const R &right) const
    {
        return {value == right, value, " == ", right};
    }
    template <typename R> Comparison<L, R> operator<=(const R &right) const
    {
        return {value <= right, value, " <= ", right};
    }
    template <typename R> Comparison<L, R> operator>=(const R &right) const
    {
        return {value >= right, value, " >= ", right};
    }
    template <typename R> Comparison<L, R> operator<(const R &right) const
    {
        return {value < right, value, " < ", right};
    }
    template <typename R> Comparison<L, R> operator>(const R &right) const
    {
        return {value > right, value, " > ", right};
    }

    std::string sides() const { return text(value); }
};

struct Split {
    template <typename L> Left<L> operator<<(const L &value) const
    {
        if constexpr (std::is_same_v<L, bool>) {
            return {value, value};
        } else {
            return {value};
        }
    }
};

// Adds a counterexample to those of the running test.
void record(const char *file, int line, const char *condition, const std::string &sides);

template <typename Outcome>
bool check(const char *file, int line, const char *condition, const Outcome &outcome)
{
    if (!outcome.holds) {
        record(file, line, condition, outcome.sides());
    }
    return outcome.holds;
}

// One named value; the list of those in scope is what a counterexample shows.
class Shown {
  public:
    template <typename T>
    Shown(const char *name, const T &value)
        : outer_(innermost_), name_(name), value_(&value),
          text_([](const void *at) { return text(*static_cast<const T *>(at)); })
    {
        innermost_ = this;
    }
    template <typename T> Shown(const char *name, const T &&value) = delete; // it must outlive this
    Shown(const Shown &) = delete;
    Shown &operator=(const Shown &) = delete;
    ~Shown() { innermost_ = outer_; }

    // Everything in scope, from the outermost on, as "; name = value".
    static std::string all();

  private:
    static Shown *innermost_;
    Shown *outer_;
    const char *name_;
    const void *value_;
    std::string (*text_)(const void *);
};

} // namespace property

#define CHECK(...)                                                                                 \
    property::check(__FILE__, __LINE__, #__VA_ARGS__, property::Split() << __VA_ARGS__)
#define PROPERTY_JOIN(a, b) a##b
#define PROPERTY_NAME(line) PROPERTY_JOIN(shown_on_line_, line)
#define SHOW(variable) const property::Shown PROPERTY_NAME(__LINE__)(#variable, variable)
