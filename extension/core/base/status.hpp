#pragma once

#include <glm/vec2.hpp>

#include <cstdint>
#include <limits>
#include <string>

namespace thicket {

/// The reason why a call was refused.
enum class ErrorCode : std::uint8_t {
	none,
	not_finite,      ///< NAN or infinite where a finite number is needed.
	not_positive,    ///< Zero or negative where a positive number is needed.
	out_of_range,    ///< Finite, but outside the range that the property documents.
	inverted,        ///< A range whose end lies before its start.
	too_many_points, ///< The request would generate more points than one call allows.
	missing,         ///< A needed object or buffer is absent.
	wrong_type,      ///< A script returned a value of a different type.
	wrong_size,      ///< A buffer or an image has the wrong size.
	out_of_memory,   ///< The machine does not have enough memory for the request.
	corrupt,         ///< Stored bytes are truncated, damaged or of a different kind.
	foreign,         ///< Ids belong to a different point set.
	not_allowed,     ///< More than the receiver's limits allow, or data that cannot be checked against them.
	out_of_order,    ///< Data that starts after all that was received: something before it is missing.
	margin_too_wide, ///< No margin within the limit decides some points; Status::site holds the position.
	cancelled,       ///< The caller's cancel flag was raised; outputs are unspecified but valid.
};

/// A position in a point set.
struct PointSetSite {
	std::uint64_t seed = 0;
	double radius = 0.0;      ///< Meters; 0 if there is no site.
	glm::dvec2 position{0.0}; ///< World meters.
};

/// The accepted values, both ends included. An infinite end is no limit; two infinite ends mean that no range is known.
struct AllowedRange {
	double min = -std::numeric_limits<double>::infinity();
	double max = std::numeric_limits<double>::infinity();
	const char *note = ""; ///< The source of a limit, or what it counts, such as "64 x tile_size"; a string literal.

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

/// The outcome of a call across the core's border, where the core throws nothing (see core/base/guard.hpp). A failed
/// call does not change the object that it was called on. Two kinds of functions cannot return a status: constructors,
/// and functions that return their result by value (a list of ids, a digest). If memory runs out, these throw
/// std::bad_alloc and change nothing.
struct [[nodiscard]] Status {
	ErrorCode code = ErrorCode::none;
	const char *property = ""; ///< The property that was refused; a string literal.
	double value = 0.0;        ///< The refused value.
	PointSetSite site{};       ///< The position, for errors that depend on one.
	/// Set for out_of_range, wrong_size, too_many_points, not_finite, inverted, not_allowed and out_of_order.
	AllowedRange allowed{};
	/// The remedy, as a sentence without its period; a string literal. If it is empty, `describe` uses the usual remedy of the code.
	const char *remedy = "";

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

	static constexpr Status wrong_type(const char *property, const char *remedy) {
		return {ErrorCode::wrong_type, property, 0.0, {}, {}, remedy};
	}
};

/// A message for a log or an editor warning: a sentence with property, value, allowed range and site, as far as they
/// are known, and a sentence with the remedy. Without the last period: "view_distance must be between 0 and 1024 (64 x
/// tile_size), got 1500. Lower it or raise tile_size".
std::string describe(const Status &status);

} // namespace thicket
