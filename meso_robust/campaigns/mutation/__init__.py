"""Tampered certificates: the checker rejects each, or what it accepts is still true.

``changes`` alters single values as an accident or a crude forger would; ``forgeries`` alters all
places that hang together, as a careful one would. The digest is refreshed each time, so that it is
the checker's physics that must object. What is accepted must fall under one of the rules of
``excuses``, which are judged without the checker.
"""
