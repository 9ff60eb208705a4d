#include "nodes/scatter/host_reader.hpp"

#include "nodes/common/property_check.hpp"
#include "nodes/ground/mesh_copy.hpp"

#include <glm/vec3.hpp>

#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Creates a surface from clockwise triangles, each with three successive corners in the list.
Status surface_of(const std::vector<glm::vec3> &corners, std::shared_ptr<const Surface> &r_surface) {
	std::vector<glm::dvec3> vertices(corners.begin(), corners.end());
	std::vector<std::uint32_t> indices;
	for (std::uint32_t first = 0; first + 2 < vertices.size(); first += 3) {
		indices.insert(indices.end(), {first, first + 2, first + 1});
	}
	return Surface::create(std::move(vertices), std::move(indices), r_surface);
}

bool same_triangles(const Surface *a, const Surface *b) {
	if (a == nullptr || b == nullptr || a->triangle_count() != b->triangle_count()) {
		return a == b;
	}
	bool is_equal = true;
	for (std::uint32_t index = 0; is_equal && index < a->triangle_count(); ++index) {
		is_equal = a->triangle(index) == b->triangle(index);
	}
	return is_equal;
}

bool same_models(const HostModels &a, const HostModels &b) {
	bool is_equal = a.size() == b.size();
	for (std::size_t mesh = 0; is_equal && mesh < a.size(); ++mesh) {
		is_equal = same_triangles(a.model(mesh), b.model(mesh));
	}
	return is_equal;
}

} // namespace

std::shared_ptr<const HostModels> HostReader::read(const LayerDrawing &drawing, std::uint64_t version) {
	std::vector<Ref<Mesh>> meshes = drawing.finest_meshes();
	if (models_ != nullptr && meshes == meshes_ && drawing.boxes == boxes_ && version == version_) {
		return models_;
	}
	problems_ = PackedStringArray();
	std::vector<std::shared_ptr<const Surface>> surfaces;
	for (std::size_t index = 0; index < meshes.size(); ++index) {
		surfaces.push_back(read_mesh(meshes[index], index));
	}
	meshes_ = std::move(meshes);
	boxes_ = drawing.boxes;
	version_ = version;
	auto models = std::make_shared<const HostModels>(std::move(surfaces));
	if (models->radius() == 0.0 && problems_.size() == 0) {
		problems_.push_back("nothing grows on this layer: its meshes have no triangles. Add a mesh with triangles, or "
							"remove this layer from the surface_layers of other layers.");
	}
	if (models_ == nullptr || !same_models(*models_, *models)) {
		// Unchanged models keep their address so that nothing is regenerated.
		models_ = std::move(models);
	}
	return models_;
}

/// Returns the triangles of a mesh, or null if it has none. If it has too many or cannot be read,
/// adds a problem and returns null.
std::shared_ptr<const Surface> HostReader::read_mesh(const Ref<Mesh> &p_mesh, std::size_t index) {
	if (p_mesh.is_null()) {
		return nullptr;
	}
	GroundPiece piece;
	piece.mesh = p_mesh;
	MeshReader reader;
	reader.start({piece}, 0, 0);
	std::shared_ptr<const MeshCopy> copy;
	while (copy == nullptr && reader.busy()) {
		copy = reader.step();
	}
	std::vector<glm::vec3> corners;
	std::shared_ptr<const Surface> surface;
	Status status = copy != nullptr ? copy->append_faces(corners) : Status();
	const String name = "ScatterLayer.meshes[" + String::num_int64(static_cast<int64_t>(index)) + "]";
	if (status.ok() && corners.size() / 3 > max_triangles) {
		problems_.push_back(
				vformat("nothing grows on %s: it has %d triangles, but a mesh on which layers grow may have at most "
						"%d. Use a mesh with fewer triangles.",
						name, static_cast<int64_t>(corners.size() / 3), static_cast<int64_t>(max_triangles)));
		return nullptr;
	}
	if (status.ok() && !corners.empty()) {
		status = surface_of(corners, surface);
	}
	if (!status.ok()) {
		problems_.push_back("nothing grows on " + name + ": " + sentence("the mesh", status));
	}
	return surface;
}

} // namespace thicket
