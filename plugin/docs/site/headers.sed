# What Doxygen reads in the place of a header: names as programs write them, without the namespace of the precision; and what
# is protected, which is for joints of one's own, is not shown.
/namespace PINTLE_PRECISION/s/.*//
s/^ protected:/ private:/
