#pragma once

#include "core/base/planet.hpp"
#include "core/base/status.hpp"
#include "core/rules/curve_table.hpp"
#include "core/rules/density_field.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>

namespace thicket {

struct LayerSettings;

/// The quantity that determines a number of an instance's appearance. Scenes store these values.
enum class SourceKind : std::uint8_t {
	random,
	height,   ///< Height of the ground in world meters, or its altitude on a planet.
	slope,    ///< Slope of the ground, in degrees.
	noise,    ///< A noise field over the plane, clamped to 0 to 1.
	rank,     ///< The thinning rank, 0 to 1.
	distance, ///< Distance in the plane to the nearest instance of a different layer, in meters.
};

/// Determines a number from 0 to 1 for an instance's appearance. The number is either random, or
/// comes from a quantity at the instance, as a fraction of a range.
struct InstanceSource {
	SourceKind kind = SourceKind::random;

	/// The range of the quantity. The fraction is 0 up to `min`, 1 from `max` on, and linear in
	/// between; if both are equal, it jumps from 0 to 1. |min| and |max| are at most
	/// max_source_value. For a distance, `max` is also the search radius, above 0 and at most
	/// max_source_distance.
	double min = 0.0;
	double max = 1.0;

	/// The random part of the number: 0 uses only the fraction, 1 is entirely random.
	double randomness = 0.0;
	std::shared_ptr<const CurveTable> curve{};    ///< Maps the number to the final one; null for no change.
	std::shared_ptr<const DensityField> noise{};  ///< Used by SourceKind::noise.
	std::shared_ptr<const LayerSettings> layer{}; ///< Used by SourceKind::distance.

	/// Returns false if the number is entirely random, because the kind is random or the noise or
	/// layer is missing.
	bool known() const {
		return kind == SourceKind::noise
				? noise != nullptr
				: kind != SourceKind::random && (kind != SourceKind::distance || layer != nullptr);
	}

	friend bool operator==(const InstanceSource &, const InstanceSource &) = default;
};

inline constexpr double max_source_value = 1e6;
inline constexpr double max_source_distance = 1e3; ///< Maximum InstanceSource::max of a distance, in meters.

/// The fraction of an instance whose number is entirely random.
inline constexpr float unknown_fraction = -1.0f;

/// The names of a source's properties for the errors of `validate`.
struct SourceNames {
	const char *min;
	const char *max;
	const char *randomness;
};

/// Returns an error for numbers that are not finite or out of range, and for a minimum above its
/// maximum. For a random source, only the randomness is checked.
Status validate(const InstanceSource &source, const SourceNames &names);

/// Returns the offset of `value` in the source's range, as a fraction from 0 to 1.
float fraction_of(const InstanceSource &source, double value);

/// Returns the fraction of a hand-placed instance. The instance's world y, or its altitude on
/// `planet`, is used as the height of the ground, and 0 as its rank. Slopes and distances are unknown.
/// `on_surface` is the layer's PointSet::on_surface. If it is true, noise also depends on world y.
float fraction_by_hand(const InstanceSource &source, glm::dvec3 position, bool on_surface, const Planet &planet = {});

/// Combines `fraction` (0 to 1 or unknown_fraction) with the instance's `random` number (0 to 1),
/// and applies the source's curve. The result is 0 to 1.
double mixed(const InstanceSource &source, float fraction, double random);

} // namespace thicket
