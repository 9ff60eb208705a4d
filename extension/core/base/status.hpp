#pragma once

#include <glm/vec2.hpp>

#include <cstdint>
#include <limits>
#include <string>

namespace thicket {

/// The reason why a call failed.
enum class ErrorCode : std::uint8_t {
	none,
	not_finite,      ///< NAN or infinite where a finite number is required.
	not_positive,    ///< Zero or negative where a positive number is required.
	out_of_range,    ///< Finite, but outside the range that the property documents.
	inverted,        ///< The end of a range lies before its start.
	too_many_points, ///< The request would generate more points than one call may return.
	missing,         ///< A required object or buffer is null.
	wrong_type,      ///< A script returned a value of the wrong type.
	wrong_size,      ///< A buffer or an image has the wrong size.
	out_of_memory,   ///< The machine does not have enough memory for the request.
	corrupt,         ///< Stored bytes are truncated, corrupt or in another format.
	foreign,         ///< Instance IDs belong to another point set.
	not_allowed,     ///< The data exceeds the receiver's limits, or cannot be checked against them.
	/// The data begins after the end of the data received so far, so a part in between is missing.
	out_of_order,
	margin_too_wide, ///< Even the widest sampling margin does not decide a point; Status::site has its position.
	cancelled,       ///< The caller's cancel flag was set. Outputs are valid but unspecified.
};

/// A position in the point set of a seed and a radius.
struct PointSetSite {
	std::uint64_t seed = 0;
	double radius = 0.0;      ///< Meters; 0 if no position is known.
	glm::dvec2 position{0.0}; ///< Position in world meters.
};

/// The range of accepted values, including both ends. An infinite end means that there is no limit.
/// If both ends are infinite, no range is known.
struct AllowedRange {
	double min = -std::numeric_limits<double>::infinity();
	double max = std::numeric_limits<double>::infinity();
	/// A string literal that explains a limit or its unit, for example "64 x tile_size".
	const char *note = "";

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

/// The outcome of a call to a public function of the core. Such calls do not throw (see
/// core/base/guard.hpp), and a failed call leaves its object unchanged. Two kinds of functions
/// cannot return a status: constructors, and functions that return their result by value (a list of
/// IDs, a digest). If memory runs out, these throw std::bad_alloc and have no effect.
struct [[nodiscard]] Status {
	ErrorCode code = ErrorCode::none;
	const char *property = ""; ///< The rejected property; a string literal.
	double value = 0.0;        ///< The rejected value.
	PointSetSite site{};       ///< The affected position, for errors that depend on one.
	/// Known for out_of_range, wrong_size, too_many_points, not_finite, inverted, not_allowed and
	/// out_of_order.
	AllowedRange allowed{};
	/// How to fix the error, as a sentence without its period; a string literal. If it is empty,
	/// `describe` uses the default for the code.
	const char *remedy = "";

	constexpr bool ok() const { return code == ErrorCode::none; }

	template <class Number>
	static constexpr Status out_of_range(
			const char *property, Number value, const AllowedRange &allowed, const char *remedy = "") {
		return {ErrorCode::out_of_range, property, static_cast<double>(value), {}, allowed, remedy};
	}

	/// Creates a wrong_size status. `size` and `allowed` must have the same unit.
	template <class Number>
	static constexpr Status wrong_size(
			const char *property, Number size, const AllowedRange &allowed, const char *remedy = "") {
		return {ErrorCode::wrong_size, property, static_cast<double>(size), {}, allowed, remedy};
	}

	template <class Number>
	static constexpr Status too_many_points(
			const char *property, double points, Number max_points, const char *remedy = "") {
		return {ErrorCode::too_many_points, property, points, {}, at_most(max_points), remedy};
	}

	static constexpr Status missing(const char *property, const char *remedy) {
		return {ErrorCode::missing, property, 0.0, {}, {}, remedy};
	}

	static constexpr Status wrong_type(const char *property, const char *remedy) {
		return {ErrorCode::wrong_type, property, 0.0, {}, {}, remedy};
	}
};

/// Returns a message for a log or an editor warning. One sentence contains the property, value,
/// allowed range and site, if they are known; another explains how to fix the error. The message
/// has no final period, for example "view_distance must be between 0 and 1024 (64 x tile_size), got
/// 1500. Lower it or raise tile_size".
std::string describe(const Status &status);

} // namespace thicket
