#pragma once

#include "core/base/status.hpp"
#include "core/rules/curve_table.hpp"
#include "core/rules/density_field.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>

namespace thicket {

struct LayerSettings;

/// The quantity that a number of an instance's look follows. Scenes store these values.
enum class SourceKind : std::uint8_t {
	random,
	height,   ///< Height of the ground, in world meters.
	slope,    ///< Slope of the ground, in degrees.
	noise,    ///< A noise field over the plane, clamped to 0 to 1.
	rank,     ///< The thinning rank, 0 to 1.
	distance, ///< Meters in the plane to the nearest placed instance of a different layer.
};

/// A number from 0 to 1 for an instance's look: random, or a value found at the instance, as its share of a range.
struct InstanceSource {
	SourceKind kind = SourceKind::random;

	/// The share is 0 at `min` and below, 1 at `max` and above, and linear in between. If `min` and `max` are equal,
	/// the share is a step. For a distance, `max` is also the search radius: above 0, at most max_source_distance.
	/// |min| and |max| are at most max_source_value.
	double min = 0.0;
	double max = 1.0;

	double randomness = 0.0; ///< The random part of the number: 0 uses the share alone, 1 is fully random.
	std::shared_ptr<const CurveTable> curve{};    ///< Replaces the number by the curve at it; null keeps it.
	std::shared_ptr<const DensityField> noise{};  ///< For SourceKind::noise.
	std::shared_ptr<const LayerSettings> layer{}; ///< For SourceKind::distance.

	/// False for a number that is only random, including noise and distance sources whose noise or layer is missing.
	bool known() const {
		return kind == SourceKind::noise
				? noise != nullptr
				: kind != SourceKind::random && (kind != SourceKind::distance || layer != nullptr);
	}

	friend bool operator==(const InstanceSource &, const InstanceSource &) = default;
};

inline constexpr double max_source_value = 1e6;
inline constexpr double max_source_distance = 1e3; ///< Meters.

/// The share of an instance whose number is random alone.
inline constexpr float unknown_share = -1.0f;

/// The names of a source's parts in a status.
struct SourceNames {
	const char *min;
	const char *max;
	const char *randomness;
};

/// Refuses numbers that are not finite or out of range, and a minimum above its maximum. For a random source, only the randomness is
/// checked.
Status validate(const InstanceSource &source, const SourceNames &names);

/// The position of `value` within the range, as a share from 0 to 1.
float share_of(const InstanceSource &source, double value);

/// The share of an instance that was placed by hand, as far as its position determines it. Its own height counts as the
/// height of the ground, its rank is 0, and slopes and distances are unknown.
float share_by_hand(const InstanceSource &source, glm::dvec3 position);

/// The resulting number, 0 to 1, with the source's curve, from `share` (0 to 1 or unknown_share) and the instance's own `random` number (0 to 1).
double mixed(const InstanceSource &source, float share, double random);

} // namespace thicket
