#pragma once

#include "core/base/status.hpp"

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/variant/string.hpp>

#include <cstdint>
#include <type_traits>

namespace thicket {

/// A bounded number among a class's properties. One constant of this type says all that the inspector, the setter and
/// its error message need to know, so a new property is one line.
template <class Values, class Number>
struct NumberProperty {
	using Limit = std::conditional_t<std::is_floating_point_v<Number>, double, std::int64_t>;

	const char *name;
	Number Values::*member;
	Limit min; ///< The smallest value taken.
	Limit max; ///< The largest value taken.
	godot::PropertyHint hint = godot::PROPERTY_HINT_NONE;
	const char *hint_string = "";
	Limit least = 0; ///< Where 0 stands for "none": the smallest other number taken, `min` being 0. 0 for no such gap.
};

template <class Values, class Number, class... Rest>
NumberProperty(const char *, Number Values::*, Rest...) -> NumberProperty<Values, Number>;

/// True for a finite value in [min, max]; otherwise prints one error that names owner, property, the allowed range and the value, and
/// is false.
bool accept_number(const char *owner, const char *property, double value, double min, double max);

/// Prints `owner`.`status` as an error of the engine; silent for a status that is fine or was cancelled.
void report(const char *owner, const Status &status);

/// What a method returns whose bytes or other arguments were refused with this status.
godot::Error error_of(const Status &status);

/// The sentence that `report` prints.
godot::String sentence(const char *owner, const Status &status);

} // namespace thicket
