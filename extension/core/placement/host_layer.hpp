#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/terrain/surface.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace thicket {

struct LayerSettings;

/// The triangles of a layer's models, for layers that grow on the models. Immutable.
class HostModels {
public:
	/// Takes one surface for each mesh of the layer, in the space of the model at scale 1. The
	/// surface of a mesh without triangles is null.
	explicit HostModels(std::vector<std::shared_ptr<const Surface>> models);

	/// Returns the triangles of a mesh, or null if it has none or there is no such mesh.
	const Surface *model(std::size_t mesh) const { return mesh < models_.size() ? models_[mesh].get() : nullptr; }
	std::size_t size() const { return models_.size(); }

	/// Returns the radius, in meters, of a ball around a model's origin that contains all triangles
	/// of the model at scale 1. It is large enough for every model of the layer.
	double radius() const { return radius_; }

private:
	std::vector<std::shared_ptr<const Surface>> models_;
	double radius_ = 0.0;
};

/// An instance of a host, which is a layer on whose models other layers grow.
struct HostInstance {
	std::uint64_t id = 0;
	std::size_t mesh = 0;
	glm::dvec3 position{0.0}; ///< World meters.
	glm::dmat3 basis{1.0};    ///< Rotation and scale, column-major as in GLM.
};

/// A snapshot of a game's changes to the instances of one host. Immutable, so threads may share it.
class HostChanges {
public:
	virtual ~HostChanges() = default;
	HostChanges(const HostChanges &) = delete;
	HostChanges &operator=(const HostChanges &) = delete;

	/// Returns true if the generated instance with this id is removed.
	virtual bool removed(std::uint64_t id) const = 0;

	/// Appends the host's hand-placed instances whose position is in the half-open `rect`, in
	/// ascending order of their ids.
	virtual Status add_placed(const Rect &rect, std::vector<HostInstance> &r_instances) const = 0;

	/// Returns an upper bound for the scale of the host's hand-placed instances, or 0 if there are
	/// none.
	virtual double max_scale() const = 0;

protected:
	HostChanges() = default;
};

/// A layer on whose models other layers grow. Two hosts are equal if all their pointers are equal.
struct HostLayer {
	std::shared_ptr<const LayerSettings> layer; ///< Never null.
	std::shared_ptr<const HostModels> models;   ///< Never null.
	std::shared_ptr<const HostChanges> changes; ///< Null if there are none.

	friend bool operator==(const HostLayer &, const HostLayer &) = default;
};

/// Returns an upper bound, in meters, for the horizontal distance from a point of the host's set to
/// the triangles of the instance that is generated there. The height offset matters only on a
/// planet, because elsewhere it moves instances straight up.
double reach_of(const HostLayer &host);

/// Returns the same bound for all instances of the host, including hand-placed ones. The distance
/// of a hand-placed instance is measured from its position.
double widest_reach_of(const HostLayer &host);

} // namespace thicket
