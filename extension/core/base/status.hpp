#pragma once

#include <glm/vec2.hpp>

#include <cstdint>
#include <string>

namespace thicket {

/// Why a call was refused.
enum class ErrorCode : std::uint8_t {
	none,
	not_finite,      ///< NAN or infinite where a finite number is needed.
	not_positive,    ///< Zero or negative where a positive number is needed.
	out_of_range,    ///< Finite, but outside the range that the property's docstring gives.
	inverted,        ///< A range whose end lies before its start.
	too_many_points, ///< The request would give more than `max_points_per_call` points.
	missing,         ///< A needed object or buffer is absent.
	wrong_size,      ///< A buffer or an image of the wrong size.
	out_of_memory,   ///< The machine has not enough memory for the request.
	corrupt,         ///< Stored bytes that are truncated, damaged or of another kind.
	foreign,         ///< Ids of another point set than those that are there.
	margin_too_wide, ///< Points that no margin in the limit decides; Status::site says where.
	cancelled,       ///< The caller's cancel flag was raised; outputs are unspecified but valid.
};

/// A position in a point set.
struct PointSetSite {
	std::uint64_t seed = 0;
	double radius = 0.0;      ///< Meters; 0 for no site.
	glm::dvec2 position{0.0}; ///< World meters.
};

/// The outcome of a call across the core's border: the core throws nothing there (see core/base/guard.hpp). A failed call
/// has no effect on the state it was called on. Two kinds of functions have no room for a status and throw std::bad_alloc
/// where memory ends: constructors, and those that return what they work out by value (a list of ids, a digest). They change
/// nothing then.
struct [[nodiscard]] Status {
	ErrorCode code = ErrorCode::none;
	const char *property = ""; ///< The property that was refused; a string literal.
	double value = 0.0;        ///< The value that it had.
	PointSetSite site{};       ///< Where it happened, of errors that depend on where.

	constexpr bool ok() const { return code == ErrorCode::none; }
};

/// One sentence that names property and value, and the site if there is one, for a log or an editor warning: "radius must be
/// positive, got -1".
std::string describe(const Status &status);

} // namespace thicket
