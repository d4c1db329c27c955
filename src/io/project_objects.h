// Models, instances and shapes of a project.
#pragma once
#include "io/project.h"
#include "io/project_reading.h"

namespace vitral {

// Reads an element of a <scene>; false when it is none of these.
bool read_object_element(Reading& reading, const XmlElement& element);

// All elements have been read: which model each instance places. Throws InputError.
void resolve_models(Reading& reading);

// Loads the models, after the scene's own meshes. Throws InputError.
void load_models(Project& project, Warnings& warnings);

// All meshes are loaded: finds the objects' materials by their names, in the scene or in the project's
// libraries, and puts the objects into the scene. Throws InputError.
void load_objects(Project& project, Warnings& warnings);

}  // namespace vitral
