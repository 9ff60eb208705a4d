#pragma once

#include "core/base/status.hpp"

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/variant/string.hpp>

#include <cstdint>
#include <string>
#include <type_traits>

namespace thicket {

/// A numeric property with limits. One constant of this type contains everything that the
/// inspector, the setter and its error message need, so adding a property takes one line.
template <class Values, class Number>
struct NumberProperty {
	using Limit = std::conditional_t<std::is_floating_point_v<Number>, double, std::int64_t>;

	const char *name;
	Number Values::*member;
	Limit min; ///< The smallest accepted value.
	Limit max; ///< The largest accepted value.
	godot::PropertyHint hint = godot::PROPERTY_HINT_NONE;
	const char *hint_string = "";
	/// The smallest accepted value other than 0, for a property whose `min` is 0 and means "none".
	/// If this is 0, every value from `min` on is accepted.
	Limit min_nonzero = 0;
};

template <class Values, class Number, class... Rest>
NumberProperty(const char *, Number Values::*, Rest...) -> NumberProperty<Values, Number>;

/// Returns true for a finite value in [min, max]. For any other value, prints an error with the
/// owner, the property, the value and the allowed range, and returns false.
bool accept_number(const char *owner, const char *property, double value, double min, double max);

/// Prints a status as a Godot error that begins with `owner`. Prints nothing if the status is ok or
/// canceled.
void report(const char *owner, const Status &status);

/// The same, but adds `details`, one or more sentences, to the message.
void report(const char *owner, const Status &status, const std::string &details);

/// Converts a status to the Error that a bound method returns.
godot::Error error_of(const Status &status);

/// Returns the message that `report` prints. It begins with `owner` and the property, for example
/// "ScatterLayer.radius". A description of several words follows a colon instead.
godot::String sentence(const char *owner, const Status &status);

} // namespace thicket
