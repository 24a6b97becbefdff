"""Where people may be, told by boosted trees and two networks that were taught with rendered images alone."""
