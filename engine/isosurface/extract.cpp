#include "engine/isosurface/extract.h"
