#pragma once

#include "core/base/status.hpp"

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/variant/string.hpp>

#include <cstdint>
#include <type_traits>

namespace thicket {

/// A bounded number among the properties of a class. One constant of this type contains all data that the inspector,
/// the setter and its error message need, so a new property takes one line.
template <class Values, class Number>
struct NumberProperty {
	using Limit = std::conditional_t<std::is_floating_point_v<Number>, double, std::int64_t>;

	const char *name;
	Number Values::*member;
	Limit min; ///< The smallest accepted value.
	Limit max; ///< The largest accepted value.
	godot::PropertyHint hint = godot::PROPERTY_HINT_NONE;
	const char *hint_string = "";
	Limit least =
			0; ///< If 0 means "none": the smallest accepted value above 0, with `min` at 0. 0 if there is no such gap.
};

template <class Values, class Number, class... Rest>
NumberProperty(const char *, Number Values::*, Rest...) -> NumberProperty<Values, Number>;

/// True for a finite value in [min, max]. For any other value, prints one error that names the owner, the property, the
/// allowed range and the value, and returns false.
bool accept_number(const char *owner, const char *property, double value, double min, double max);

/// Prints `owner`.`status` as an error of the engine. Prints nothing if the status is ok or cancelled.
void report(const char *owner, const Status &status);

/// Converts the status with which a method refused its arguments into the Error that it returns.
godot::Error error_of(const Status &status);

/// The sentence that `report` prints.
godot::String sentence(const char *owner, const Status &status);

} // namespace thicket
