"""Provides the package's version and addresses to scikit-build-core, from the add-on's plugin.cfg, which is the only file that
contains them."""

import configparser
from pathlib import Path


class Provider:
    @staticmethod
    def dynamic_metadata(_settings, _project):
        plugin = configparser.ConfigParser()
        # A source distribution has a copy beside this file.
        paths = (Path("plugin.cfg"), Path("../demo_project/addons/thicket/plugin.cfg"))
        with next(path for path in paths if path.is_file()).open(encoding="utf-8") as file:
            plugin.read_file(file)
        version, repository, documentation = (
            plugin[section][key].strip('"')
            for section, key in (("plugin", "version"), ("thicket", "repository"), ("thicket", "documentation"))
        )
        urls = {"Documentation": documentation, "Repository": repository, "Issues": repository + "/issues"}
        return {"version": version, "urls": urls}
