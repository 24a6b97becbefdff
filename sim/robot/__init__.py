"""The PeopleBot: body, wheels, encoders, sonars, settings and appearance."""
