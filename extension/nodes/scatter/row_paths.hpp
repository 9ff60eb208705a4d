#pragma once

#include "core/base/status.hpp"
#include "core/rows/row_set.hpp"
#include "nodes/region/scatter_region_3d.hpp"

#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/classes/path3d.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace thicket {

/// Reads the Path3D nodes of the groups that the layers of a TerrainScatter3D name in ScatterRows, and
/// builds sets of rows from them. Use it only on the main thread.
class RowPaths {
public:
	/// Returns true if a path has been added, removed or changed since the last update. Call this
	/// every frame, because a moved Path3D emits no signal. Each call checks a limited number of
	/// paths. After the first change, the remaining paths of its group are checked before the
	/// function returns true.
	bool have_changed(const godot::Node3D &host, const RegionHost &world);

	/// Begins an update in which `rows_for` is called for each layer with rows. If `was_recentered`
	/// is true, changes of positions that are due to rounding to single precision are ignored.
	void begin_update(const godot::Node3D &host, const RegionHost &world, bool was_recentered);

	/// Sets `r_rows` to the rows of a layer along the paths of a group. The pointer stays the same until
	/// its content changes. After an error, such as a path that is too long, `r_rows` is unchanged.
	Status rows_for(const std::string &group, const RowSettings &settings, std::shared_ptr<const RowSet> &r_rows);

	/// Discards groups that the current update has not used.
	void end_update();

	/// Returns the number of paths in a group that the last update used.
	std::size_t path_count(const std::string &group) const;

private:
	/// The state of a path when it was last read.
	struct PathState {
		godot::Variant node;
		std::uint64_t id = 0;
		godot::StringName name;
		std::uint64_t parent = 0;
		godot::Transform3D transform;
		godot::PackedVector3Array points;

		bool is_same(const PathState &other) const;
	};

	struct Group {
		godot::StringName name;
		bool is_used = true;
		bool is_outdated = true;    ///< True if paths may have been added or removed, so that all are read again.
		std::int64_t count = 0;     ///< Number of nodes in the group when it was last read.
		std::size_t next_index = 0; ///< Index of the next path to check.
		std::set<std::size_t> changed_indices; ///< Indices of the paths that have changed.
		/// Number of paths to check before the changed ones are read, so that paths that change together
		/// are read together.
		std::size_t remaining_checks = 0;
		std::vector<PathState> paths;
		std::vector<SharedRowLine> lines; ///< For each path.
	};

	static PathState state_of(const godot::Path3D &path, const RegionHost &world);
	static void check(Group &r_group, const RegionHost &world);
	void read(Group &r_group) const;
	void read_changed(Group &r_group) const;
	RowLine line_of(const PathState &path) const;

	std::map<std::string, Group> groups_;
	std::vector<std::shared_ptr<const RowSet>> sets_; ///< The sets of the last update, and those of the current one.
	std::size_t former_set_count_ = 0; ///< The number of sets, at the start of `sets_`, that belong to the last update.
	const godot::Node3D *host_ = nullptr; ///< Valid during an update.
	const RegionHost *world_ = nullptr;
	bool was_recentered_ = false;
};

} // namespace thicket
