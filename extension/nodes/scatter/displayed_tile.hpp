#pragma once

#include "core/base/rect.hpp"
#include "core/placement/draw_cells.hpp"
#include "core/placement/lod_span.hpp"
#include "nodes/scatter/tile_visual.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace thicket {

/// What is drawn of one tile: of each mesh the whole tile as one, or a part of it for each cell in which instances stand.
struct DisplayedTile {
	/// The instances of one mesh that are drawn, counted and culled as one. All that the renderer has of them is reached through here.
	struct Cell {
		explicit Cell(TileVisual its_visual) : visual(std::move(its_visual)) {}

		TileVisual visual; ///< Of the first of the LODs that are drawn.

		/// Of the LODs that follow, while some of the instances are as far away as those are for; all of them draw the same instances.
		std::vector<TileVisual> others;
		glm::vec3 min{0.0f}; ///< The box around what is drawn, relative to the tile's origin.
		glm::vec3 max{0.0f};
		LodSpan span;             ///< The LODs that are wanted,
		std::size_t lod = 0;      ///< and the one that is drawn alone as long as not all of these have a visual.
		double density = 1.0;     ///< What is left by thinning, quality and the limit for all tiles, whatever the LOD.
		float scale = 1.0F;       ///< What TileVisual::set_scale was told.
		std::size_t drawn = 0;    ///< How many of the instances the visual draws,
		std::uint64_t wanted = 0; ///< and would draw without a limit for all tiles together.

		void set_box(const godot::AABB &box);
		void set_instances(const MeshUpload &upload);

		template <class Work>
		void for_each_visual(const Work &work) {
			work(visual);
			for (TileVisual &other : others) {
				work(other);
			}
		}
	};

	/// The instances of one mesh.
	struct Part {
		std::vector<Cell>
				cells;      ///< One for the whole tile, or as `division` has them; none where there is nothing to draw.
		DrawCells division; ///< Of `shown`; empty for a tile that is drawn as a whole.
		std::vector<double> due; ///< Of each cell, LodSchedule::traveled from which it may have to be drawn otherwise.
		std::vector<MeshLook> lods;            ///< The mesh, then the coarser ones; empty if there is no mesh.
		std::shared_ptr<const KeptMesh> shown; ///< The tile's own, or what is left and added by the overlay.

		/// How many cells it has once all are uploaded.
		std::size_t cell_count() const {
			return lods.empty() || shown->size() == 0 ? 0 : division.empty() ? 1 : division.cells.size();
		}
		bool is_open() const { return cells.size() < cell_count(); }

		/// How many multimeshes a cell takes.
		std::size_t multimeshes_of_a_cell() const { return casts_by_other_meshes(lods) ? 2 : 1; }
		std::size_t multimesh_count() const;
		std::span<const std::uint32_t> ranks_of(std::size_t cell) const {
			return division.empty() ? shown->ranks() : division.ranks_of(division.cells[cell]);
		}
	};

	std::shared_ptr<const KeptTile> tile; ///< What the layer's rules give.
	SharedLayer settings;                 ///< That it was made by.
	std::vector<float> mesh_reach;        ///< Of the meshes that it was made for, as LayerDrawing has it.
	Rect rect;
	std::vector<Part> parts;
	std::uint32_t across = 1; ///< Cells along a side; 1 for a tile that is drawn as a whole.

	glm::vec3 min{std::numeric_limits<float>::max()};  ///< The box around all that is drawn, relative to the origin;
	glm::vec3 max{-std::numeric_limits<float>::max()}; ///< inside out where nothing is.
	std::uint64_t drawing_version = 0;                 ///< Of what the layer said when it was last drawn.
	bool look_at_all = true;                           ///< At the next visit, also at cells that are not due.
	bool is_cut = false;                               ///< The limit for all tiles together cuts it short.
	bool to_divide = false;                            ///< It waits to be divided otherwise.
	bool to_fade = false;                              ///< It waits for visuals of LODs that are wanted.

	float reach_of(std::size_t mesh) const { return mesh < mesh_reach.size() ? mesh_reach[mesh] : 0.0F; }
	bool draws_anything() const { return min.x <= max.x; }
	void grow(const godot::AABB &box);
	void set_visible(bool visible);
	void set_offset(glm::dvec3 offset);

	/// The finest that any cell shows; 0 if there is none.
	std::size_t finest_lod() const;
	void set_lod(std::size_t lod);
	std::size_t cell_count() const;

	/// Of main memory, that its instances take.
	std::size_t bytes() const;

	/// How many multimeshes its cells have, and would have, at most, in another division.
	std::size_t multimesh_count() const;
	std::size_t most_multimeshes(std::uint32_t across_then) const;
};

/// The instances of a part in one of its cells as the renderer takes them. `reach` as in to_upload.
MeshUpload to_upload(const DisplayedTile::Part &part, std::size_t cell, float reach);

/// What the RenderingServer holds for a part, in the tile's order. Slow: it waits for the renderer.
godot::PackedFloat32Array read_back(const DisplayedTile::Part &part);

} // namespace thicket
