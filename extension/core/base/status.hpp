#pragma once

#include <glm/vec2.hpp>

#include <cstdint>
#include <limits>
#include <string>

namespace thicket {

/// Why a call was refused.
enum class ErrorCode : std::uint8_t {
	none,
	not_finite,      ///< NAN or infinite where a finite number is needed.
	not_positive,    ///< Zero or negative where a positive number is needed.
	out_of_range,    ///< Finite, but outside the range that the property's docstring gives.
	inverted,        ///< A range whose end lies before its start.
	too_many_points, ///< The request would give more points than one call makes.
	missing,         ///< A needed object or buffer is absent.
	wrong_size,      ///< A buffer or an image of the wrong size.
	out_of_memory,   ///< The machine has not enough memory for the request.
	corrupt,         ///< Stored bytes that are truncated, damaged or of another kind.
	foreign,         ///< Ids of another point set than those that are there.
	not_allowed,     ///< More than the limits that a receiver has set, or what they cannot be checked for.
	out_of_order,    ///< What begins after all that was received: something is missing before it.
	margin_too_wide, ///< Points that no margin in the limit decides; Status::site says where.
	cancelled,       ///< The caller's cancel flag was raised; outputs are unspecified but valid.
};

/// A position in a point set.
struct PointSetSite {
	std::uint64_t seed = 0;
	double radius = 0.0;      ///< Meters; 0 for no site.
	glm::dvec2 position{0.0}; ///< World meters.
};

/// What would have been accepted, both ends included; infinite ends are no limits, and two of them name no range at all.
struct AllowedRange {
	double min = -std::numeric_limits<double>::infinity();
	double max = std::numeric_limits<double>::infinity();
	const char *note = ""; ///< Where a limit comes from or what it counts, such as "64 x tile_size"; a string literal.

	constexpr bool has_min() const { return min > std::numeric_limits<double>::lowest(); }
	constexpr bool has_max() const { return max < std::numeric_limits<double>::max(); }
};

template <class Min, class Max>
constexpr AllowedRange between(Min min, Max max, const char *note = "") {
	return {static_cast<double>(min), static_cast<double>(max), note};
}

template <class Max>
constexpr AllowedRange at_most(Max max, const char *note = "") {
	return {AllowedRange().min, static_cast<double>(max), note};
}

template <class Min>
constexpr AllowedRange at_least(Min min, const char *note = "") {
	return {static_cast<double>(min), AllowedRange().max, note};
}

template <class Number>
constexpr AllowedRange exactly(Number number, const char *note = "") {
	return between(number, number, note);
}

/// The outcome of a call across the core's border: the core throws nothing there (see core/base/guard.hpp). A failed call
/// has no effect on the state it was called on. Two kinds of functions have no room for a status and throw std::bad_alloc
/// where memory ends: constructors, and those that return what they work out by value (a list of ids, a digest). They change
/// nothing then.
struct [[nodiscard]] Status {
	ErrorCode code = ErrorCode::none;
	const char *property = ""; ///< The property that was refused; a string literal.
	double value = 0.0;        ///< The value that it had.
	PointSetSite site{};       ///< Where it happened, of errors that depend on where.
	AllowedRange
			allowed{}; ///< Of out_of_range, wrong_size, too_many_points, not_finite, inverted, not_allowed and out_of_order.
	const char *remedy =
			""; ///< What to do about it, as a sentence without its period; a string literal. Empty for what the code suggests.

	constexpr bool ok() const { return code == ErrorCode::none; }

	template <class Number>
	static constexpr Status out_of_range(
			const char *property, Number value, const AllowedRange &allowed, const char *remedy = "") {
		return {ErrorCode::out_of_range, property, static_cast<double>(value), {}, allowed, remedy};
	}

	/// `size` and `allowed` count the same things.
	template <class Number>
	static constexpr Status wrong_size(
			const char *property, Number size, const AllowedRange &allowed, const char *remedy = "") {
		return {ErrorCode::wrong_size, property, static_cast<double>(size), {}, allowed, remedy};
	}

	template <class Number>
	static constexpr Status too_many_points(const char *property, double points, Number most, const char *remedy = "") {
		return {ErrorCode::too_many_points, property, points, {}, at_most(most), remedy};
	}

	static constexpr Status missing(const char *property, const char *remedy) {
		return {ErrorCode::missing, property, 0.0, {}, {}, remedy};
	}
};

/// A sentence that names property, value, allowed range and site, as far as they are known, and one with the remedy, for a log or an
/// editor warning; without the last period: "view_distance must be between 0 and 1024 (64 x tile_size), got 1500. Lower it or raise
/// tile_size".
std::string describe(const Status &status);

} // namespace thicket
