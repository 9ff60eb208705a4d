#include "core/placement/instance_source.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"

#include <glm/vec2.hpp>

#include <algorithm>

namespace thicket {

namespace {

Status validate_range(const InstanceSource &source, const SourceNames &names) {
	Status status = first_failure(check_range(names.min, source.min, -max_source_value, max_source_value),
			check_range(names.max, source.max, -max_source_value, max_source_value),
			check_order(names.max, source.min, source.max));
	if (status.ok() && source.kind == SourceKind::distance) {
		status = first_failure(
				check_positive(names.max, source.max), check_range(names.max, source.max, 0.0, max_source_distance));
	}
	return status;
}

} // namespace

Status validate(const InstanceSource &source, const SourceNames &names) {
	const Status status = check_range(names.randomness, source.randomness, 0.0, 1.0);
	return status.ok() && source.kind != SourceKind::random ? validate_range(source, names) : status;
}

float fraction_of(const InstanceSource &source, double value) {
	// The maximum is checked first, so that a step (min == max) includes its position.
	if (value >= source.max) {
		return 1.0f;
	}
	return value > source.min ? static_cast<float>((value - source.min) / (source.max - source.min)) : 0.0f;
}

float fraction_by_hand(const InstanceSource &source, glm::dvec3 position, bool on_surface, const Planet &planet) {
	const glm::dvec2 in_plane{position.x, position.z};
	const auto height = static_cast<float>(position.y);
	const PositionBatch batch{{&in_plane, 1}, {&height, on_surface ? std::size_t{1} : 0}};
	float density = 0.0f;
	switch (source.kind) {
		case SourceKind::height: return fraction_of(source, planet.exists() ? planet.altitude(position) : position.y);
		case SourceKind::rank: return fraction_of(source, 0.0);
		case SourceKind::noise:
			return source.noise != nullptr && source.noise->sample_at(batch, {&density, 1}).ok()
					? fraction_of(source, unit_density(density))
					: unknown_fraction;
		default: return unknown_fraction;
	}
}

double mixed(const InstanceSource &source, float fraction, double random) {
	const double number = fraction < 0.0f
			? random
			: std::min(double{fraction} * (1.0 - source.randomness) + random * source.randomness, 1.0);
	return source.curve != nullptr ? source.curve->at(number) : number;
}

} // namespace thicket
