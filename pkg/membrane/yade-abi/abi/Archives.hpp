// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <abi/Abi.hpp>

// The four archives YADE writes and reads; export.hpp must come after all of them.
#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/archive/xml_iarchive.hpp>
#include <boost/archive/xml_oarchive.hpp>

#include <boost/serialization/export.hpp>

#include <boost/serialization/base_object.hpp>
#include <boost/serialization/factory.hpp>
#include <boost/serialization/list.hpp>
#include <boost/serialization/map.hpp>
#include <boost/serialization/nvp.hpp>
#include <boost/serialization/shared_ptr.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/vector.hpp>
