#pragma once

#include "core/base/status.hpp"
#include "core/rules/density_field.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>

namespace thicket {

struct LayerSettings;

/// What a number of an instance's look follows. The values are those that scenes store.
enum class SourceKind : std::uint8_t {
	random,
	height,   ///< Of the ground, in world meters.
	slope,    ///< Of the ground, in degrees.
	noise,    ///< A field of the plane, held to 0 to 1.
	rank,     ///< The thinning rank, 0 to 1.
	distance, ///< Meters in the plane to the nearest standing instance of another layer.
};

/// A number from 0 to 1 of an instance's look: random, or a share of a range of what is found where the instance stands.
struct InstanceSource {
	SourceKind kind = SourceKind::random;

	/// The share is 0 at `min` and below, 1 at `max` and above, and straight between; where both are the same, a step. For a
	/// distance, `max` is also how far an instance looks: above 0, at most max_source_distance. |min| and |max| are at
	/// most max_source_value.
	double min = 0.0;
	double max = 1.0;

	double randomness = 0.0; ///< How much of the number is random all the same: 0 the share alone, 1 random alone.
	std::shared_ptr<const DensityField> noise{};  ///< For SourceKind::noise.
	std::shared_ptr<const LayerSettings> layer{}; ///< For SourceKind::distance.

	/// False for a number that is random alone, as it is for a noise or a layer that is not there.
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

/// What a status calls the parts of a source.
struct SourceNames {
	const char *min;
	const char *max;
	const char *randomness;
};

/// Refuses what is not finite, out of range, or a minimum above its maximum. Only the randomness counts for a source that is
/// random.
Status validate(const InstanceSource &source, const SourceNames &names);

/// The share of the range, 0 to 1, at which `value` lies.
float share_of(const InstanceSource &source, double value);

/// The share of an instance that was placed by hand, as far as its position tells: its height counts as that of the ground, its
/// rank is 0, and of slopes and distances nothing is known.
float share_by_hand(const InstanceSource &source, glm::dvec3 position);

/// The number: from `share`, 0 to 1 or unknown_share, and the instance's own `random` number, 0 to 1. 0 to 1.
double mixed(const InstanceSource &source, float share, double random);

} // namespace thicket
